var searchData=
[
  ['part_0',['Part',['../collision_8hpp.html#a8507e246446150268702ed99d2a1200f',1,'agrisee::arm']]],
  ['pickingreason_1',['PickingReason',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3d',1,'agrisee']]],
  ['pointclass_2',['PointClass',['../density_8hpp.html#a57853a2d6ea90aba60dbb5b15cf3ef33',1,'agrisee::see']]]
];

var searchData=
[
  ['blocked_5fby_5ffruit_0',['blocked_by_fruit',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3dab9ff19e13748cc25937476d45b54ac1b',1,'agrisee']]],
  ['blocked_5fby_5fkeep_5fout_1',['blocked_by_keep_out',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3dacb6a0ff6902f64255eb61c700e9451df',1,'agrisee']]]
];

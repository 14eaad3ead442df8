var searchData=
[
  ['vector3_0',['Vector3',['../types_8hpp.html#af9cd43eec3d9128a347b999e45e0bea4',1,'agrisee']]]
];

var searchData=
[
  ['objectclass_0',['ObjectClass',['../geometry_2scene_8hpp.html#ab51ff960e11fb463eac1808f7549d34d',1,'agrisee']]]
];

var searchData=
[
  ['z_0',['z',['../classagrisee_1_1Grid.html#a05acbf138e2f2c5d6fb6649630e791f1',1,'agrisee::Grid']]]
];

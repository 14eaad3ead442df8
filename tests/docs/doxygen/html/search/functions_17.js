var searchData=
[
  ['x_0',['x',['../classagrisee_1_1Grid.html#a5d4bcdc3652bc4c24fa549dc341ffff1',1,'agrisee::Grid']]]
];

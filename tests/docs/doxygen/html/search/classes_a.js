var searchData=
[
  ['kdtree_0',['KdTree',['../classagrisee_1_1KdTree.html',1,'agrisee']]],
  ['keepout_1',['KeepOut',['../structagrisee_1_1KeepOut.html',1,'agrisee']]],
  ['keyed_2',['Keyed',['../structagrisee_1_1Keyed.html',1,'agrisee']]]
];

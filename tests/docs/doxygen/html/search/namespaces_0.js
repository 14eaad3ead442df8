var searchData=
[
  ['ur3_0',['ur3',['../namespaceagrisee_1_1arm_1_1ur3.html',1,'agrisee::arm']]]
];

var searchData=
[
  ['aabb_0',['Aabb',['../structagrisee_1_1Aabb.html',1,'agrisee']]],
  ['approachanswer_1',['ApproachAnswer',['../structagrisee_1_1plan_1_1ApproachAnswer.html',1,'agrisee::plan']]],
  ['approachrequest_2',['ApproachRequest',['../structagrisee_1_1plan_1_1ApproachRequest.html',1,'agrisee::plan']]],
  ['atomicfile_3',['AtomicFile',['../classagrisee_1_1io_1_1AtomicFile.html',1,'agrisee::io']]]
];

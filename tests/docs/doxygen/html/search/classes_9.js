var searchData=
[
  ['jointlimits_0',['JointLimits',['../structagrisee_1_1arm_1_1JointLimits.html',1,'agrisee::arm']]],
  ['jointpath_1',['JointPath',['../structagrisee_1_1study_1_1JointPath.html',1,'agrisee::study']]]
];

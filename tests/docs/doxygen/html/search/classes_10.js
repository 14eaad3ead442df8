var searchData=
[
  ['randomplanner_0',['RandomPlanner',['../classagrisee_1_1plan_1_1RandomPlanner.html',1,'agrisee::plan']]],
  ['rayimage_1',['RayImage',['../structagrisee_1_1sensor_1_1RayImage.html',1,'agrisee::sensor']]],
  ['reachableapproach_2',['ReachableApproach',['../structagrisee_1_1plan_1_1ReachableApproach.html',1,'agrisee::plan']]],
  ['reachableview_3',['ReachableView',['../structagrisee_1_1plan_1_1ReachableView.html',1,'agrisee::plan']]],
  ['reached_4',['Reached',['../structagrisee_1_1arm_1_1Reached.html',1,'agrisee::arm']]],
  ['reachparameters_5',['ReachParameters',['../structagrisee_1_1arm_1_1ReachParameters.html',1,'agrisee::arm']]],
  ['regiongrowingparameters_6',['RegionGrowingParameters',['../structagrisee_1_1RegionGrowingParameters.html',1,'agrisee']]],
  ['reportinfo_7',['ReportInfo',['../structagrisee_1_1io_1_1ReportInfo.html',1,'agrisee::io']]],
  ['rng_8',['Rng',['../classagrisee_1_1Rng.html',1,'agrisee']]],
  ['runfile_9',['RunFile',['../structagrisee_1_1io_1_1RunFile.html',1,'agrisee::io']]],
  ['runinfo_10',['RunInfo',['../structagrisee_1_1io_1_1RunInfo.html',1,'agrisee::io']]]
];

var searchData=
[
  ['gainplanner_0',['GainPlanner',['../classagrisee_1_1plan_1_1GainPlanner.html',1,'agrisee::plan']]],
  ['gainplannerparameters_1',['GainPlannerParameters',['../structagrisee_1_1plan_1_1GainPlannerParameters.html',1,'agrisee::plan']]],
  ['greedycover_2',['GreedyCover',['../classagrisee_1_1study_1_1GreedyCover.html',1,'agrisee::study']]],
  ['greedyorder_3',['GreedyOrder',['../structagrisee_1_1study_1_1GreedyOrder.html',1,'agrisee::study']]],
  ['greedyplanner_4',['GreedyPlanner',['../classagrisee_1_1study_1_1GreedyPlanner.html',1,'agrisee::study']]],
  ['grid_5',['Grid',['../classagrisee_1_1Grid.html',1,'agrisee']]],
  ['groundtruth_6',['GroundTruth',['../structagrisee_1_1study_1_1GroundTruth.html',1,'agrisee::study']]],
  ['growthaxisparameters_7',['GrowthAxisParameters',['../structagrisee_1_1GrowthAxisParameters.html',1,'agrisee']]]
];

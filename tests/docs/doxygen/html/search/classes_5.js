var searchData=
[
  ['faultparameters_0',['FaultParameters',['../structagrisee_1_1study_1_1FaultParameters.html',1,'agrisee::study']]],
  ['faultrecord_1',['FaultRecord',['../structagrisee_1_1study_1_1FaultRecord.html',1,'agrisee::study']]],
  ['fileerror_2',['FileError',['../structagrisee_1_1FileError.html',1,'agrisee']]],
  ['fingerprint_3',['Fingerprint',['../classagrisee_1_1io_1_1Fingerprint.html',1,'agrisee::io']]],
  ['fitparameters_4',['FitParameters',['../structagrisee_1_1FitParameters.html',1,'agrisee']]],
  ['fixedplanner_5',['FixedPlanner',['../classagrisee_1_1plan_1_1FixedPlanner.html',1,'agrisee::plan']]],
  ['foot_6',['Foot',['../structagrisee_1_1Ellipsoid_1_1Foot.html',1,'agrisee::Ellipsoid']]],
  ['foundbody_7',['FoundBody',['../structagrisee_1_1FoundBody.html',1,'agrisee']]],
  ['freedirection_8',['FreeDirection',['../structagrisee_1_1see_1_1FreeDirection.html',1,'agrisee::see']]],
  ['freespaceparameters_9',['FreeSpaceParameters',['../structagrisee_1_1plan_1_1FreeSpaceParameters.html',1,'agrisee::plan']]],
  ['frontier_10',['Frontier',['../structagrisee_1_1see_1_1Frontier.html',1,'agrisee::see']]],
  ['fruit_11',['Fruit',['../structagrisee_1_1Fruit.html',1,'agrisee']]],
  ['fruitmetrics_12',['FruitMetrics',['../structagrisee_1_1study_1_1FruitMetrics.html',1,'agrisee::study']]],
  ['fruitshape_13',['FruitShape',['../structagrisee_1_1study_1_1FruitShape.html',1,'agrisee::study']]],
  ['fruitshare_14',['FruitShare',['../structagrisee_1_1study_1_1FruitShare.html',1,'agrisee::study']]]
];

var searchData=
[
  ['edge_0',['edge',['../structagrisee_1_1sensor_1_1NoiseParameters.html#a38bd89b8033c395bf855211548f3d322',1,'agrisee::sensor::NoiseParameters']]],
  ['elongation_1',['elongation',['../structagrisee_1_1study_1_1TrussParameters.html#a00553688c549ea9e134e7b03eba11580',1,'agrisee::study::TrussParameters']]],
  ['enabled_2',['enabled',['../structagrisee_1_1plan_1_1PickingParameters.html#a0f1591e195aae365ead7dcaade6b301f',1,'agrisee::plan::PickingParameters']]],
  ['end_3',['end',['../structagrisee_1_1plan_1_1ApproachRequest.html#a4098f59c0cac44623fc5f40f37641a50',1,'agrisee::plan::ApproachRequest']]],
  ['eps_4',['eps',['../structagrisee_1_1DbscanParameters.html#a782e8c86077928fbc7a5dee80fa333dc',1,'agrisee::DbscanParameters']]],
  ['equatorial_5',['equatorial',['../structagrisee_1_1study_1_1FruitShape.html#a274df60d8f5d2fa123cbfd5a6177ef7f',1,'agrisee::study::FruitShape']]],
  ['error_6',['error',['../structagrisee_1_1Estimate.html#a9a25d0e9498366b4a64d0b50b77f007c',1,'agrisee::Estimate']]],
  ['exact_7',['exact',['../structagrisee_1_1study_1_1JointPath.html#a8cabb955b89a851ec8ba5442c8fefad8',1,'agrisee::study::JointPath']]],
  ['expected_8',['expected',['../structagrisee_1_1plan_1_1GainPlannerParameters.html#adab5bc32d3d903eef4a1dc340697bc9d',1,'agrisee::plan::GainPlannerParameters']]],
  ['eye_9',['eye',['../structagrisee_1_1plan_1_1PickingScene.html#a98d7567a8cc94cf49c3cd658ac5931dc',1,'agrisee::plan::PickingScene::eye()'],['../structagrisee_1_1study_1_1TrussLayout.html#ab307e899b141c6b11e43047cc77b5fe1',1,'agrisee::study::TrussLayout::eye()']]]
];

var searchData=
[
  ['paperlocalization_0',['PaperLocalization',['../structagrisee_1_1study_1_1PaperLocalization.html',1,'agrisee::study']]],
  ['paperscanning_1',['PaperScanning',['../structagrisee_1_1study_1_1PaperScanning.html',1,'agrisee::study']]],
  ['papersegmentation_2',['PaperSegmentation',['../structagrisee_1_1study_1_1PaperSegmentation.html',1,'agrisee::study']]],
  ['papertext_3',['PaperText',['../structagrisee_1_1study_1_1PaperText.html',1,'agrisee::study']]],
  ['papertruss_4',['PaperTruss',['../structagrisee_1_1study_1_1PaperTruss.html',1,'agrisee::study']]],
  ['parametererror_5',['ParameterError',['../structagrisee_1_1ParameterError.html',1,'agrisee']]],
  ['parameters_6',['Parameters',['../structagrisee_1_1Parameters.html',1,'agrisee::Parameters'],['../structagrisee_1_1see_1_1Parameters.html',1,'agrisee::see::Parameters']]],
  ['part_7',['Part',['../structagrisee_1_1Completeness_1_1Part.html',1,'agrisee::Completeness']]],
  ['picking_8',['Picking',['../structagrisee_1_1Picking.html',1,'agrisee']]],
  ['pickingparameters_9',['PickingParameters',['../structagrisee_1_1plan_1_1PickingParameters.html',1,'agrisee::plan']]],
  ['pickingscene_10',['PickingScene',['../structagrisee_1_1plan_1_1PickingScene.html',1,'agrisee::plan']]],
  ['piece_11',['Piece',['../structagrisee_1_1arm_1_1Piece.html',1,'agrisee::arm']]],
  ['pipeline_12',['Pipeline',['../classagrisee_1_1Pipeline.html',1,'agrisee']]],
  ['placedfruit_13',['PlacedFruit',['../structagrisee_1_1study_1_1PlacedFruit.html',1,'agrisee::study']]],
  ['planner_14',['Planner',['../classagrisee_1_1plan_1_1Planner.html',1,'agrisee::plan::Planner'],['../classagrisee_1_1see_1_1Planner.html',1,'agrisee::see::Planner']]],
  ['pointcloud_15',['PointCloud',['../structagrisee_1_1PointCloud.html',1,'agrisee']]],
  ['pointcloud2view_16',['PointCloud2View',['../classagrisee_1_1interop_1_1PointCloud2View.html',1,'agrisee::interop']]],
  ['pointcloud_3c_20float_20_3e_17',['PointCloud&lt; float &gt;',['../structagrisee_1_1PointCloud.html',1,'agrisee']]],
  ['principalaxes_18',['PrincipalAxes',['../structagrisee_1_1PrincipalAxes.html',1,'agrisee']]],
  ['progress_19',['Progress',['../structagrisee_1_1plan_1_1Progress.html',1,'agrisee::plan']]]
];

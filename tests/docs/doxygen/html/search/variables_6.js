var searchData=
[
  ['gain_0',['gain',['../structagrisee_1_1Parameters.html#a55ab0922988ca8f7da32e7f724472bd8',1,'agrisee::Parameters::gain()'],['../structagrisee_1_1plan_1_1ReachableView.html#acc5345e0fbe3cd9a2344372b7be24a5a',1,'agrisee::plan::ReachableView::gain()']]],
  ['give_5fup_5fradius_1',['give_up_radius',['../structagrisee_1_1see_1_1Parameters.html#a4cc73f69b8cb03bd1be587a8c2462e9d',1,'agrisee::see::Parameters']]],
  ['grid_2',['grid',['../structagrisee_1_1CountingGrid.html#a7df5d743295a6c932f4192931fd739bc',1,'agrisee::CountingGrid']]],
  ['gripper_5fradius_3',['gripper_radius',['../structagrisee_1_1plan_1_1PickingParameters.html#a59c899fd7c76964236f58b0cde10c393',1,'agrisee::plan::PickingParameters']]],
  ['growing_4',['growing',['../structagrisee_1_1SplitParameters.html#aa90563224bd43878bac25953c5696e0c',1,'agrisee::SplitParameters::growing()'],['../structagrisee_1_1StageParameters.html#a7986941efa64e69bcc465763c78092f8',1,'agrisee::StageParameters::growing()'],['../structagrisee_1_1study_1_1CellRecord.html#a37194f86266259e2a57f7a5d63dce590',1,'agrisee::study::CellRecord::growing()']]],
  ['growing_5freach_5',['growing_reach',['../structagrisee_1_1SplitParameters.html#ad7e02adee96c94e11050d96e16c646a0',1,'agrisee::SplitParameters']]],
  ['growth_5faxis_6',['growth_axis',['../structagrisee_1_1Parameters.html#aee0e2714efbd7d13179bad2abe48cc98',1,'agrisee::Parameters::growth_axis()'],['../structagrisee_1_1study_1_1TrueFruit.html#a0d3dd285b3cf238b9c3aa3d7969c515f',1,'agrisee::study::TrueFruit::growth_axis()']]]
];

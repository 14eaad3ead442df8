var searchData=
[
  ['jacobian_0',['jacobian',['../ur3_8hpp.html#ae696a1b53c6780b24aada28ac8a55586',1,'agrisee::arm']]],
  ['join_1',['join',['../classagrisee_1_1DisjointSets.html#a2588cb90fd455a30efc3233a0f2ac1d8',1,'agrisee::DisjointSets']]],
  ['join_5fneighbors_2',['join_neighbors',['../components_8hpp.html#a2ff1e2d4c99d0ead374cc83b98c3798f',1,'agrisee']]],
  ['joint_5fconfigurations_3',['joint_configurations',['../joint__path_8hpp.html#a39b1c487f0eae84bce97d4dfee2400f4',1,'agrisee::study']]],
  ['joint_5fdistance_4',['joint_distance',['../limits_8hpp.html#a29706146c8e0c5095f01171c1fd9f101',1,'agrisee::arm']]],
  ['joint_5fpath_2ehpp_5',['joint_path.hpp',['../joint__path_8hpp.html',1,'']]],
  ['joint_5fpath_5flength_6',['joint_path_length',['../joint__path_8hpp.html#ada39b57f5fd42ce5170197ed7e922331',1,'agrisee::study::joint_path_length(const Joints &amp;start, const std::vector&lt; View &gt; &amp;views)'],['../joint__path_8hpp.html#a8cb81b126e36e2865dbefea8c463eb7b',1,'agrisee::study::joint_path_length(const Joints &amp;start, const std::vector&lt; Joints &gt; &amp;configurations)']]],
  ['jointlimits_7',['JointLimits',['../structagrisee_1_1arm_1_1JointLimits.html',1,'agrisee::arm']]],
  ['jointpath_8',['JointPath',['../structagrisee_1_1study_1_1JointPath.html',1,'agrisee::study']]],
  ['joints_9',['joints',['../structagrisee_1_1View.html#aaaa2f20e9fd453b57d056c2e9cad41ee',1,'agrisee::View']]],
  ['joints_10',['Joints',['../types_8hpp.html#a65b5549283a51e372f01900586c971ea',1,'agrisee']]],
  ['joints_11',['joints',['../structagrisee_1_1Picking.html#a1c305bca87f2e561f75124c887396c3f',1,'agrisee::Picking::joints()'],['../structagrisee_1_1plan_1_1ReachableView.html#af3c8421ed69868f7cf9ef043a8e8a5e0',1,'agrisee::plan::ReachableView::joints()'],['../structagrisee_1_1plan_1_1PickingScene.html#a47525f9b37e83757f30bd58ca1da04cc',1,'agrisee::plan::PickingScene::joints()'],['../structagrisee_1_1plan_1_1ReachableApproach.html#ab963b70d96f3b2b4833f84bc3d46efed',1,'agrisee::plan::ReachableApproach::joints()'],['../structagrisee_1_1io_1_1ViewRecord.html#a2671a92628b0992d777bdc2cb5465de7',1,'agrisee::io::ViewRecord::joints()'],['../structagrisee_1_1arm_1_1Reached.html#a5fe1663b5f40e4d9619c88558a82a690',1,'agrisee::arm::Reached::joints()']]],
  ['judge_5fscene_12',['judge_scene',['../run__cell_8hpp.html#a9aa063ace5c215be2a479538f9cc0a0c',1,'agrisee::study']]]
];

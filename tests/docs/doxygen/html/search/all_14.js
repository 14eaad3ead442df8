var searchData=
[
  ['u_0',['u',['../structagrisee_1_1Bvh_1_1Hit.html#a79276e9feef811a634f92577b9536791',1,'agrisee::Bvh::Hit::u()'],['../structagrisee_1_1TriangleHit.html#a3effc6d1d964560d286e639f88acdcd5',1,'agrisee::TriangleHit::u()']]],
  ['uniform_1',['uniform',['../classagrisee_1_1Rng.html#a1c324e75bd291736348f902492535377',1,'agrisee::Rng::uniform()'],['../classagrisee_1_1Rng.html#add398c97d9346cfadc970584ab0a7f1a',1,'agrisee::Rng::uniform(double low, double high)']]],
  ['unknown_2',['unknown',['../free__space_8hpp.html#a7020aa455ff10ca0ea93b03c2fed2ea8aad921d60486366258809553a3db49a4a',1,'agrisee::plan']]],
  ['unknown_5fweight_3',['unknown_weight',['../structagrisee_1_1plan_1_1ExpectedSurfaceParameters.html#a23764672aad00ca5a294abbf32117b28',1,'agrisee::plan::ExpectedSurfaceParameters']]],
  ['unobstructed_4',['unobstructed',['../visibility_8hpp.html#a8a99040bf6b3212c2825fc90d864984a',1,'agrisee::study']]],
  ['unsigned_5fnormals_5',['unsigned_normals',['../structagrisee_1_1RegionGrowingParameters.html#ab6b60543ebf513ae72d2fba20ad48cef',1,'agrisee::RegionGrowingParameters']]],
  ['up_5fweight_6',['up_weight',['../structagrisee_1_1GrowthAxisParameters.html#a59d186c4270cbb93017152468e37fdba',1,'agrisee::GrowthAxisParameters']]],
  ['update_7',['update',['../classagrisee_1_1plan_1_1ExpectedSurface.html#a362d3f71fc4f246468c968d0df0dcea1',1,'agrisee::plan::ExpectedSurface']]],
  ['upsilon_8',['upsilon',['../structagrisee_1_1see_1_1Parameters.html#a5c86ed94913da107bc83d5947ced44c9',1,'agrisee::see::Parameters']]],
  ['ur3_9',['ur3',['../structagrisee_1_1arm_1_1JointLimits.html#aed3992b6b6ee8e9bfc4112dadc04e73b',1,'agrisee::arm::JointLimits']]],
  ['ur3_2ehpp_10',['ur3.hpp',['../ur3_8hpp.html',1,'']]],
  ['ur3_5fpieces_11',['ur3_pieces',['../collision_8hpp.html#a342f3c12dab265377751fea2a8f9fadb',1,'agrisee::arm']]]
];

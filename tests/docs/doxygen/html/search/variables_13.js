var searchData=
[
  ['u_0',['u',['../structagrisee_1_1Bvh_1_1Hit.html#a79276e9feef811a634f92577b9536791',1,'agrisee::Bvh::Hit::u()'],['../structagrisee_1_1TriangleHit.html#a3effc6d1d964560d286e639f88acdcd5',1,'agrisee::TriangleHit::u()']]],
  ['unknown_5fweight_1',['unknown_weight',['../structagrisee_1_1plan_1_1ExpectedSurfaceParameters.html#a23764672aad00ca5a294abbf32117b28',1,'agrisee::plan::ExpectedSurfaceParameters']]],
  ['unsigned_5fnormals_2',['unsigned_normals',['../structagrisee_1_1RegionGrowingParameters.html#ab6b60543ebf513ae72d2fba20ad48cef',1,'agrisee::RegionGrowingParameters']]],
  ['up_5fweight_3',['up_weight',['../structagrisee_1_1GrowthAxisParameters.html#a59d186c4270cbb93017152468e37fdba',1,'agrisee::GrowthAxisParameters']]],
  ['upsilon_4',['upsilon',['../structagrisee_1_1see_1_1Parameters.html#a5c86ed94913da107bc83d5947ced44c9',1,'agrisee::see::Parameters']]]
];

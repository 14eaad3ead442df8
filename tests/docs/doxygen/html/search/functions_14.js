var searchData=
[
  ['uniform_0',['uniform',['../classagrisee_1_1Rng.html#a1c324e75bd291736348f902492535377',1,'agrisee::Rng::uniform()'],['../classagrisee_1_1Rng.html#add398c97d9346cfadc970584ab0a7f1a',1,'agrisee::Rng::uniform(double low, double high)']]],
  ['unobstructed_1',['unobstructed',['../visibility_8hpp.html#a8a99040bf6b3212c2825fc90d864984a',1,'agrisee::study']]],
  ['update_2',['update',['../classagrisee_1_1plan_1_1ExpectedSurface.html#a362d3f71fc4f246468c968d0df0dcea1',1,'agrisee::plan::ExpectedSurface']]],
  ['ur3_3',['ur3',['../structagrisee_1_1arm_1_1JointLimits.html#aed3992b6b6ee8e9bfc4112dadc04e73b',1,'agrisee::arm::JointLimits']]],
  ['ur3_5fpieces_4',['ur3_pieces',['../collision_8hpp.html#a342f3c12dab265377751fea2a8f9fadb',1,'agrisee::arm']]]
];

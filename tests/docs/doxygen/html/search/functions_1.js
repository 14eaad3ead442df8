var searchData=
[
  ['ball_5fstencil_0',['ball_stencil',['../stencil_8hpp.html#aa24d7d5b7345034508156ef62049a852',1,'agrisee']]],
  ['base_5fsearch_1',['base_search',['../base__search_8hpp.html#ab762b047d6be500139ac785c4ab93e8a',1,'agrisee::study']]],
  ['below_2',['below',['../classagrisee_1_1Rng.html#aa4993974a46aa1985149d08e56a2fe7a',1,'agrisee::Rng']]],
  ['best_3',['best',['../classagrisee_1_1study_1_1GreedyCover.html#a74a0ae21e3e495582927f3a629bdf0a6',1,'agrisee::study::GreedyCover']]],
  ['best_5fmatching_4',['best_matching',['../matching_8hpp.html#ad847c4de7daf9d47403278a446078064',1,'agrisee::study']]],
  ['between_5',['between',['../proposal_8hpp.html#a972637eaa82d308e583472ee08d732bf',1,'agrisee::see']]],
  ['bezier_6',['bezier',['../truss__parts_8hpp.html#ac04a59090574ef400c8ffd97f5316a54',1,'agrisee::study']]],
  ['bin_7',['bin',['../structagrisee_1_1DirectionBins.html#a7c6c0839d91953aac36cdbd6d0928e92',1,'agrisee::DirectionBins']]],
  ['bits_8',['bits',['../classagrisee_1_1Rng.html#a6aa80b1f323287b0abaa06e4b941ffd6',1,'agrisee::Rng']]],
  ['bodies_9',['bodies',['../classagrisee_1_1plan_1_1ExpectedSurface.html#a8538e3c94aea6025ca9bafaf7e339d66',1,'agrisee::plan::ExpectedSurface']]],
  ['bounds_10',['bounds',['../classagrisee_1_1Bvh.html#a0aa81443cd968d24a82e0938dd37a64d',1,'agrisee::Bvh']]],
  ['box_5fstencil_11',['box_stencil',['../stencil_8hpp.html#af9cb6e0bdb7e25bb5832d2f38f06bc49',1,'agrisee']]],
  ['bvh_12',['bvh',['../classagrisee_1_1TracedScene.html#aa3dcf33f0fcec2491400fe75e33a5e4b',1,'agrisee::TracedScene']]],
  ['bvh_13',['Bvh',['../classagrisee_1_1Bvh.html#af6c5637a57ff68692898ac58f6bab7cd',1,'agrisee::Bvh::Bvh()=default'],['../classagrisee_1_1Bvh.html#ac25b59a6ca1715371c336caa902d2c96',1,'agrisee::Bvh::Bvh(const Mesh &amp;mesh, int threads=1)']]]
];

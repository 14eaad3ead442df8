var searchData=
[
  ['gain_0',['gain',['../classagrisee_1_1plan_1_1ExpectedSurface.html#ade324bd9f21310f04f014063acf7abd5',1,'agrisee::plan::ExpectedSurface::gain()'],['../classagrisee_1_1study_1_1GreedyCover.html#aa6a007d56a8a0d1859214d4c47b4c45b',1,'agrisee::study::GreedyCover::gain()']]],
  ['gainplanner_1',['GainPlanner',['../classagrisee_1_1plan_1_1GainPlanner.html#a8376a2a92e60599a1b26812170b15310',1,'agrisee::plan::GainPlanner']]],
  ['gather_2',['gather',['../structagrisee_1_1Tile.html#a9b37aa4c949fa0033deb08ba50843499',1,'agrisee::Tile']]],
  ['given_5fup_3',['given_up',['../classagrisee_1_1see_1_1Planner.html#a3b94ea253835f0fd8d56e5111ffdabcc',1,'agrisee::see::Planner']]],
  ['greedy_5forder_4',['greedy_order',['../greedy_8hpp.html#a4b1a2d58f69a1e4c53bc3e6f09d7083b',1,'agrisee::study']]],
  ['greedycover_5',['GreedyCover',['../classagrisee_1_1study_1_1GreedyCover.html#ad34f5723d81ed2f62a190484f866f9f9',1,'agrisee::study::GreedyCover']]],
  ['greedyplanner_6',['GreedyPlanner',['../classagrisee_1_1study_1_1GreedyPlanner.html#a07a881052294ef4cc2f9359906033775',1,'agrisee::study::GreedyPlanner']]],
  ['grid_7',['Grid',['../classagrisee_1_1Grid.html#a22c44e8d2b7aa2127f6cdf35f53a4e95',1,'agrisee::Grid']]],
  ['grid_8',['grid',['../classagrisee_1_1see_1_1DensityMap.html#ad6d5c3293f85fe30619679b588d78049',1,'agrisee::see::DensityMap']]],
  ['grid_9',['Grid',['../grid_8hpp.html#ae042136dbb05d206558e469ea6b57bbd',1,'agrisee']]],
  ['ground_5ftruth_10',['ground_truth',['../study_2ground__truth_8hpp.html#a6bb459acb9c1b59ddbf52084f781c1ed',1,'agrisee::study']]],
  ['grow_5fregions_11',['grow_regions',['../region__growing_8hpp.html#a5b30292ff4b4b40ce821b033550a7f21',1,'agrisee::grow_regions(const C &amp;cloud, const std::vector&lt; Vector3&lt; scalar_t&lt; C &gt; &gt; &gt; &amp;normals, const RegionGrowingParameters &amp;params, const Search &amp;search, const std::vector&lt; scalar_t&lt; C &gt; &gt; &amp;curvatures={})'],['../region__growing_8hpp.html#a1a7a06b1ac727c5b9fadd6a0ccf227db',1,'agrisee::grow_regions(const C &amp;cloud, const std::vector&lt; Vector3&lt; scalar_t&lt; C &gt; &gt; &gt; &amp;normals, const RegionGrowingParameters &amp;params, const NeighborLists &amp;lists, const std::vector&lt; scalar_t&lt; C &gt; &gt; &amp;curvatures={})'],['../region__growing_8hpp.html#a34b2e9404bcda9095aaaf1824b7aa283',1,'agrisee::grow_regions(const C &amp;cloud, const std::vector&lt; Vector3&lt; scalar_t&lt; C &gt; &gt; &gt; &amp;normals, const RegionGrowingParameters &amp;params={}, const std::vector&lt; scalar_t&lt; C &gt; &gt; &amp;curvatures={}, int threads=1)']]],
  ['growth_5faxis_12',['growth_axis',['../poses_8hpp.html#aea86d318ca33e5e585cb28d7931420b6',1,'agrisee']]]
];

var searchData=
[
  ['dbscan_0',['dbscan',['../dbscan_8hpp.html#a9d15076c70f16cac1cfc40ef6cf79b29',1,'agrisee::dbscan(const C &amp;cloud, const DbscanParameters &amp;params={}, int threads=1)'],['../dbscan_8hpp.html#a293df12a88ea16bac691999998d36d18',1,'agrisee::dbscan(const C &amp;cloud, const DbscanParameters &amp;params, const Search &amp;search, int threads=1)']]],
  ['deepest_1',['deepest',['../structagrisee_1_1study_1_1TrussLayout.html#aabcdf185d697fba54154189fa5b47ee3',1,'agrisee::study::TrussLayout']]],
  ['deg_2',['deg',['../types_8hpp.html#ae402bf1eab2dd91c50a6e3142c65c530',1,'agrisee']]],
  ['degenerate_3',['degenerate',['../classagrisee_1_1Bvh.html#a85e1b60c44cf55255fb860c918301a43',1,'agrisee::Bvh']]],
  ['densest_5fpoint_4',['densest_point',['../poses_8hpp.html#a19682e79af74604a586baeee25c54c06',1,'agrisee']]],
  ['densitymap_5',['DensityMap',['../classagrisee_1_1see_1_1DensityMap.html#a3d9d26041b6f0e1e251b0a4b42a4b882',1,'agrisee::see::DensityMap::DensityMap(const Parameters &amp;params, double separation)'],['../classagrisee_1_1see_1_1DensityMap.html#a14296744413d32bc521675de8f53b74b',1,'agrisee::see::DensityMap::DensityMap(const Parameters &amp;params)']]],
  ['depth_6',['depth',['../structagrisee_1_1study_1_1PlacedFruit.html#a9c94b9ac517d30bbf6d68089e9393a6e',1,'agrisee::study::PlacedFruit']]],
  ['depth_5fframe_7',['depth_frame',['../ros_8hpp.html#a92bdd18bbe976bec2fbe11ca99b3347e',1,'agrisee::interop']]],
  ['depth_5fin_5ffruit_8',['depth_in_fruit',['../truss__parts_8hpp.html#af49369ca2a2e9856c85954873d856c5e',1,'agrisee::study']]],
  ['direction_9',['direction',['../classagrisee_1_1Rng.html#ab0ef68b7898aef01dc3a0f4993de2b54',1,'agrisee::Rng']]],
  ['directions_10',['directions',['../structagrisee_1_1DirectionBins.html#a476902406525e0369cb73c1f681615b5',1,'agrisee::DirectionBins']]],
  ['disjointsets_11',['DisjointSets',['../classagrisee_1_1DisjointSets.html#aec3aa6e4d4525eb71607a4f40256b43a',1,'agrisee::DisjointSets']]],
  ['distance_12',['distance',['../ellipsoid_8hpp.html#aa90794c52ef0a2081d3679c1238fdb8d',1,'agrisee::distance(const OrientedEllipsoid &amp;e, const Eigen::Vector3d &amp;p)'],['../primitives_8hpp.html#a3b66f1a044da6536801a423c1c67d18f',1,'agrisee::distance(const KeepOut &amp;k, const Eigen::Vector3d &amp;a, const Eigen::Vector3d &amp;b)'],['../primitives_8hpp.html#a03c37fbb6fd8993406d5cd1c484e8be7',1,'agrisee::distance(const Cylinder &amp;c, const Eigen::Vector3d &amp;a, const Eigen::Vector3d &amp;b)'],['../primitives_8hpp.html#a4df995b335f83b2a10e5e6693b799192',1,'agrisee::distance(const Box &amp;box, const Eigen::Vector3d &amp;a, const Eigen::Vector3d &amp;b)'],['../primitives_8hpp.html#a797e657f0f514f6bd47a8bb2fbd66636',1,'agrisee::distance(const KeepOut &amp;k, const Eigen::Vector3d &amp;p)'],['../primitives_8hpp.html#a26b4b58d44d4ee921cd029ed40d9bca7',1,'agrisee::distance(const Cylinder &amp;c, const Eigen::Vector3d &amp;p)'],['../primitives_8hpp.html#a8e8233ad15225303f2a2d9fd1df9d60b',1,'agrisee::distance(const Box &amp;box, const Eigen::Vector3d &amp;p)'],['../ellipsoid_8hpp.html#a6334f8e130037d6452bf7a4f90d04eb1',1,'agrisee::distance(const OrientedEllipsoid &amp;e, const Eigen::Vector3d &amp;a, const Eigen::Vector3d &amp;b)'],['../structagrisee_1_1Aabb.html#a9c49ff95d6c19ba7eac29e090eff6b8c',1,'agrisee::Aabb::distance()'],['../structagrisee_1_1Ellipsoid.html#a5430b0ac8cd1d3540c8ef9c011d6ead0',1,'agrisee::Ellipsoid::distance()']]],
  ['distance_5fsq_13',['distance_sq',['../neighbors_8hpp.html#adcae95a8e0fbe30eb5f91c1cdfc423cb',1,'agrisee']]],
  ['distances_5fsq_14',['distances_sq',['../structagrisee_1_1Tile.html#aadffc8c060113670625e0324218ce3a8',1,'agrisee::Tile']]],
  ['distances_5fto_5ftry_15',['distances_to_try',['../reachability_8hpp.html#a07524061b696fbdafdf4c7ee62984a42',1,'agrisee::arm']]],
  ['draw_5fgrowth_5faxis_16',['draw_growth_axis',['../truss__layout_8hpp.html#a60f7667d7b14c81ca88a184182652c49',1,'agrisee::study']]],
  ['draw_5fshape_17',['draw_shape',['../truss__layout_8hpp.html#a4df40bebc30ebd22c4b8c90650b8642a',1,'agrisee::study']]],
  ['drop_18',['drop',['../classagrisee_1_1study_1_1GreedyCover.html#a3a434b6222f6b00a62adbe31609421d5',1,'agrisee::study::GreedyCover']]],
  ['drop_5fsmall_19',['drop_small',['../split_8hpp.html#a8e9ae1517fea84be0355f48e9f736548',1,'agrisee']]],
  ['dropped_20',['dropped',['../classagrisee_1_1study_1_1GreedyCover.html#a28dbf3f03cd588ff8d03a9568111a84e',1,'agrisee::study::GreedyCover']]]
];

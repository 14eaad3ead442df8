var searchData=
[
  ['k_0',['k',['../structagrisee_1_1see_1_1Parameters.html#a89cee8aed68ffac900aed4a12ef4e78b',1,'agrisee::see::Parameters']]],
  ['kdtree_1',['KdTree',['../classagrisee_1_1KdTree.html#abc2c12a1d16e83afce34cf1429ea44e2',1,'agrisee::KdTree::KdTree()'],['../kdtree_8hpp.html#a11c69b37ea66f7eceb678b215325863f',1,'agrisee::KdTree()']]],
  ['keep_2',['keep',['../classagrisee_1_1SeparatedCloud.html#ab8df1e247e17d6e478b3bee38340b0fe',1,'agrisee::SeparatedCloud::keep()'],['../classagrisee_1_1see_1_1DensityMap.html#a664bb6b650df1804bda64d73c4ff6c15',1,'agrisee::see::DensityMap::keep()'],['../classagrisee_1_1see_1_1Planner.html#a903412cfe9d99a5d88f12662de84ed23',1,'agrisee::see::Planner::keep()']]],
  ['knn_3',['knn',['../classagrisee_1_1Grid.html#a58695fdbe018a5510e8c8ef52a17336f',1,'agrisee::Grid::knn()'],['../classagrisee_1_1KdTree.html#a8af0440b3d48b3371615726bfd8c3500',1,'agrisee::KdTree::knn()']]]
];

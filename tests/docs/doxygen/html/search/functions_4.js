var searchData=
[
  ['edge_0',['edge',['../structagrisee_1_1see_1_1VisibilityGraph.html#a88265c21f8725790f45b17bbdfb03164',1,'agrisee::see::VisibilityGraph']]],
  ['ellipsoid_1',['Ellipsoid',['../structagrisee_1_1Ellipsoid.html#a319c2c4a77f5759dfc82376d6a54ecfc',1,'agrisee::Ellipsoid']]],
  ['empty_2',['empty',['../structagrisee_1_1PointCloud.html#a582770f2f9485baf45f1128496abbe7c',1,'agrisee::PointCloud::empty()'],['../structagrisee_1_1Aabb.html#a19b5354868dbd7bc07fc3816fb0d1827',1,'agrisee::Aabb::empty()']]],
  ['enclosing_5fcapsule_3',['enclosing_capsule',['../overlap_8hpp.html#ae8d985c7f5c599b043a5291248ab4e3a',1,'agrisee']]],
  ['estimate_5fnoise_4',['estimate_noise',['../spacing_8hpp.html#ad796c591c62967043e78fde97953b8d6',1,'agrisee']]],
  ['estimate_5fnormals_5',['estimate_normals',['../normals_8hpp.html#a692363490d4def63da2de1bdcc60f839',1,'agrisee::estimate_normals(const C &amp;cloud, const NormalParameters &amp;params={}, int threads=1, std::vector&lt; scalar_t&lt; C &gt; &gt; *curvatures=nullptr)'],['../normals_8hpp.html#a80414edc057ad9544b7f4aa664ec6204',1,'agrisee::estimate_normals(const C &amp;cloud, const NormalParameters &amp;params, const NeighborLists &amp;lists, int threads=1, std::vector&lt; scalar_t&lt; C &gt; &gt; *curvatures=nullptr)'],['../normals_8hpp.html#a2e688bebbedab65a19577976c61c0167',1,'agrisee::estimate_normals(const C &amp;cloud, const NormalParameters &amp;params, const Search &amp;search, int threads=1, std::vector&lt; scalar_t&lt; C &gt; &gt; *curvatures=nullptr)']]],
  ['estimate_5fspacing_6',['estimate_spacing',['../spacing_8hpp.html#a276cd70eea3a4029b748c248ab5ece20',1,'agrisee::estimate_spacing(const C &amp;cloud)'],['../spacing_8hpp.html#a1e45bec77bb62cdbf2c1a97f705f45f4',1,'agrisee::estimate_spacing(const C &amp;cloud, const Search &amp;search, std::size_t samples=1000)']]],
  ['evaluate_7',['evaluate',['../evaluate_8hpp.html#a08ff35047df68c0d0ced0f646935c057',1,'agrisee::study']]],
  ['exchange_8',['exchange',['../classagrisee_1_1CellTable.html#a7adfaff3e1aea3ed0869fe9097294a41',1,'agrisee::CellTable']]],
  ['expect_5fradii_9',['expect_radii',['../structagrisee_1_1Parameters.html#a5ef3b4664f1523a5e7d0127f5d2bc1be',1,'agrisee::Parameters']]],
  ['expectedsurface_10',['ExpectedSurface',['../classagrisee_1_1plan_1_1ExpectedSurface.html#aa35165115d6cec0959c04891ae961b00',1,'agrisee::plan::ExpectedSurface']]],
  ['extend_11',['extend',['../structagrisee_1_1Aabb.html#ae9aa16e062b86cb7cc8997acd4371c75',1,'agrisee::Aabb']]],
  ['extent_12',['extent',['../classagrisee_1_1plan_1_1ExpectedSurface.html#a4aa8bc510338a031bd6654866969072b',1,'agrisee::plan::ExpectedSurface']]]
];

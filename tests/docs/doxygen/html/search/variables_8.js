var searchData=
[
  ['icp_0',['icp',['../structagrisee_1_1Parameters.html#a2d1f7676ccf5560ce4b6fb1115440f62',1,'agrisee::Parameters']]],
  ['id_1',['id',['../structagrisee_1_1Object.html#a129425626e8ad985d4f8e22ba864572b',1,'agrisee::Object::id()'],['../structagrisee_1_1Fruit.html#aa110f985ad76c71d7142f126e57e9689',1,'agrisee::Fruit::id()'],['../structagrisee_1_1study_1_1LocatedFruit.html#afde73ac7c522b821098a500e3e590f0e',1,'agrisee::study::LocatedFruit::id()'],['../structagrisee_1_1study_1_1TrueFruit.html#ace406c60de9788c8a72c1226a5cade4c',1,'agrisee::study::TrueFruit::id()'],['../structagrisee_1_1study_1_1FruitMetrics.html#a91304d953e41ebec1d2d84421a2e724a',1,'agrisee::study::FruitMetrics::id()'],['../structagrisee_1_1study_1_1FruitShare.html#abeeb2fee634b172fe2db09ce62c4d4fd',1,'agrisee::study::FruitShare::id()']]],
  ['ids_2',['ids',['../structagrisee_1_1Neighborhood.html#aa52f1af61e3cc75b082f351d16551de7',1,'agrisee::Neighborhood::ids()'],['../structagrisee_1_1NeighborLists.html#a1227574db4b0a5895e59e6ff1fe0e030',1,'agrisee::NeighborLists::ids()']]],
  ['images_3',['images',['../structagrisee_1_1plan_1_1Progress.html#aebeba5071dcd43847a6cd5ee0dff1422',1,'agrisee::plan::Progress']]],
  ['independent_4',['independent',['../structagrisee_1_1FitParameters.html#a797cef422f8538c5449bda1c3cc18d61',1,'agrisee::FitParameters']]],
  ['index_5',['index',['../structagrisee_1_1see_1_1Frontier.html#af66d3e1c8f6782d294d703dbe37bb211',1,'agrisee::see::Frontier::index()'],['../structagrisee_1_1Keyed.html#a51a30ecaacf1350a635341c4e5234d01',1,'agrisee::Keyed::index()'],['../structagrisee_1_1Neighbor.html#a2347d40fda1868193ff619fc37328824',1,'agrisee::Neighbor::index()']]],
  ['info_6',['info',['../structagrisee_1_1io_1_1RunFile.html#ac2a43b99bbfa07be07dcfac2cc2cf827',1,'agrisee::io::RunFile']]],
  ['inliers_7',['inliers',['../structagrisee_1_1EllipsoidFit.html#a425bf6a5372b0e5f72fae56570a238ef',1,'agrisee::EllipsoidFit']]],
  ['inner_8',['inner',['../structagrisee_1_1StencilRow.html#affe90834c1173982dcddb185f21ad679',1,'agrisee::StencilRow']]],
  ['inside_9',['inside',['../structagrisee_1_1Tile.html#a1e01b63868a8563e5f6c829132ff6779',1,'agrisee::Tile']]],
  ['instance_10',['instance',['../structagrisee_1_1io_1_1CloudFile.html#a559b6d096ea0d2937fcd4c576566f2b4',1,'agrisee::io::CloudFile::instance()'],['../structagrisee_1_1study_1_1FruitMetrics.html#a138db23dfa0e7df7a744cfc0ba9f7bbc',1,'agrisee::study::FruitMetrics::instance()']]],
  ['intrinsics_11',['intrinsics',['../structagrisee_1_1sensor_1_1DepthFrame.html#a8f33fc6e250b47de40061080fbad29da',1,'agrisee::sensor::DepthFrame::intrinsics()'],['../structagrisee_1_1sensor_1_1L515.html#a4c323a87d00cf35dae11c861578e3f3d',1,'agrisee::sensor::L515::intrinsics()'],['../structagrisee_1_1sensor_1_1SurfaceImage.html#a02130e3a60951c8596a085aed61c3f2a',1,'agrisee::sensor::SurfaceImage::intrinsics()']]],
  ['intrinsics_5ferror_12',['intrinsics_error',['../structagrisee_1_1study_1_1FaultParameters.html#a0eb20089b070fe10e17894d7dd2b2bd3',1,'agrisee::study::FaultParameters']]],
  ['invented_13',['invented',['../structagrisee_1_1study_1_1FaultRecord.html#a654ec1a63431a36cb021a31a781d5f9b',1,'agrisee::study::FaultRecord']]],
  ['iterations_14',['iterations',['../structagrisee_1_1IcpResult.html#ab1d8b757f0c3158d5eac410cee908337',1,'agrisee::IcpResult::iterations()'],['../structagrisee_1_1FitParameters.html#a5f1160fefaa5ba072d469ca33c27492c',1,'agrisee::FitParameters::iterations()']]]
];

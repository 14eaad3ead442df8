var searchData=
[
  ['valid_0',['valid',['../structagrisee_1_1sensor_1_1DepthFrame.html#ad85f4f04a0b46d1777a72acaa2ca0537',1,'agrisee::sensor::DepthFrame']]],
  ['value_1',['value',['../classagrisee_1_1io_1_1Fingerprint.html#a8fd9d4c79bd44f8222ca1d50b2d89a7f',1,'agrisee::io::Fingerprint']]],
  ['view_2',['view',['../structagrisee_1_1io_1_1Bytes.html#adfde06ab938724654c35159bb43a1702',1,'agrisee::io::Bytes']]],
  ['view_5fof_3',['view_of',['../proposal_8hpp.html#af03d00abea91b273e2b67f23eddac26c',1,'agrisee::see']]],
  ['view_5frecord_5fpath_4',['view_record_path',['../scan__record_8hpp.html#a3c9b99e7b4e3f73f5efa9b7649fe56d8',1,'agrisee::io']]],
  ['views_5',['views',['../classagrisee_1_1Pipeline.html#ab8cda743208e4af832357b64b64d9122',1,'agrisee::Pipeline']]],
  ['views_5ffor_6',['views_for',['../structagrisee_1_1study_1_1GreedyOrder.html#a11e9551d3c45ab81a98dbda8ac87286c',1,'agrisee::study::GreedyOrder']]],
  ['views_5ftaken_7',['views_taken',['../classagrisee_1_1see_1_1Planner.html#adbe9e1c9c2f80a4e1f901b8a3a80e349',1,'agrisee::see::Planner']]],
  ['visibility_5fgraph_8',['visibility_graph',['../visibility__graph_8hpp.html#addddc31c5a694ca3ef56de6124afe7ac',1,'agrisee::see']]],
  ['visible_5ffrom_9',['visible_from',['../visibility_8hpp.html#a33f771003b5f5b9f4ac1b40d0c266f24',1,'agrisee::study']]],
  ['visible_5fto_10',['visible_to',['../visibility_8hpp.html#a0221b6eed90fa680f6822e22d5ae3337',1,'agrisee::study']]],
  ['visit_11',['visit',['../classagrisee_1_1Bvh.html#a3e558c0e9fbb7f97d892eff3e3b6fd81',1,'agrisee::Bvh::visit()'],['../classagrisee_1_1KdTree.html#af749a00bca172d3ec82f970484ebbf12',1,'agrisee::KdTree::visit()'],['../classagrisee_1_1HashGrid.html#ad5c2123202b1ad67725d4cca3fe8d86a',1,'agrisee::HashGrid::visit()'],['../classagrisee_1_1Grid.html#a0ddddbca4d66d8b0b324cf11353a7930',1,'agrisee::Grid::visit()'],['../structagrisee_1_1NeighborLists.html#a38e7d93e9b026f7ed46a16073f736407',1,'agrisee::NeighborLists::visit()']]],
  ['volume_12',['volume',['../volume_8hpp.html#a890f172b6761b698443d8df4bba7d33a',1,'agrisee::volume(const Ellipsoid &amp;body)'],['../mesh_8hpp.html#a512d72843d27fb6f10b64cf01dd5a432',1,'agrisee::volume(const Mesh &amp;mesh)']]],
  ['volume_5fof_13',['volume_of',['../volume_8hpp.html#a2cfb9fb47124fda79f5d2c9883351c6f',1,'agrisee']]],
  ['vote_5ffor_5fcenters_14',['vote_for_centers',['../sphere__voting_8hpp.html#a6ab083f54bf2f1f47247fe9a5c27e9d9',1,'agrisee']]]
];

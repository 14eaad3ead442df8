var searchData=
[
  ['add_0',['add',['../classagrisee_1_1SurfelMap.html#a4fa29ad69237fe62fa78f08071e3c348',1,'agrisee::SurfelMap::add()'],['../classagrisee_1_1Moments.html#a3dab6b90e9c81046b8eba6068f959390',1,'agrisee::Moments::add()'],['../classagrisee_1_1io_1_1Fingerprint.html#a5034f010c929ccc3f9fadd5606335e22',1,'agrisee::io::Fingerprint::add(const void *data, std::size_t size)'],['../classagrisee_1_1io_1_1Fingerprint.html#a14e3be27721824e6ac57d6d3a5936eaa',1,'agrisee::io::Fingerprint::add(std::string_view text)'],['../classagrisee_1_1io_1_1Fingerprint.html#aa61d7136faf944c3ac6943d69f7b402f',1,'agrisee::io::Fingerprint::add(const Scene &amp;scene)'],['../classagrisee_1_1SeparatedCloud.html#a4067901d69fa76a987796aa49ed0d6d3',1,'agrisee::SeparatedCloud::add()']]],
  ['all_1',['all',['../classagrisee_1_1study_1_1GreedyCover.html#a0257a42e896dc2c4d6ed06519f7b8869',1,'agrisee::study::GreedyCover']]],
  ['angle_5fof_2',['angle_of',['../icp__parameters_8hpp.html#a8bae9a3a2afa57a1bbd5845bc7c0c207',1,'agrisee']]],
  ['any_3',['any',['../classagrisee_1_1Bvh.html#a41a94f1e87af80b3798087fd5ae5ae3b',1,'agrisee::Bvh']]],
  ['any_5forthogonal_4',['any_orthogonal',['../pose_8hpp.html#a6cfd5aee5f3e12e99e959faeb7abaddd',1,'agrisee']]],
  ['append_5',['append',['../structagrisee_1_1Tile.html#a311f52dd5580ef2457db58b8cf184901',1,'agrisee::Tile::append()'],['../mesh_8hpp.html#a3823ccea60a9fb823126de539b9a96b4',1,'agrisee::append()']]],
  ['append_5fsamples_6',['append_samples',['../samples_8hpp.html#a289894c160dae3457dce16052d1a2385',1,'agrisee::study']]],
  ['approach_5fof_7',['approach_of',['../arm__approach_8hpp.html#a6ff9226f210202057ff10f60189d5a78',1,'agrisee::plan']]],
  ['area_8',['area',['../mesh_8hpp.html#ac5e825b354724b6801f1574c687dddeb',1,'agrisee::area()'],['../classagrisee_1_1plan_1_1ExpectedSurface.html#a8289d86cb5e7f5868f048660d7d854a8',1,'agrisee::plan::ExpectedSurface::area()']]],
  ['area_5fnormal_9',['area_normal',['../triangle_8hpp.html#a865b24432169dcb3024046a1e6746984',1,'agrisee']]],
  ['areas_10',['areas',['../classagrisee_1_1plan_1_1ExpectedSurface.html#af0a5172090b1d244d094bc23b55ad337',1,'agrisee::plan::ExpectedSurface']]],
  ['assign_5fto_5fbodies_11',['assign_to_bodies',['../bodies_8hpp.html#a04dcb7753164224f8c0ac94a6a248123',1,'agrisee']]],
  ['at_12',['at',['../structagrisee_1_1sensor_1_1DepthFrame.html#acbbed5b78d4a09e61c8057b0a8e6c46f',1,'agrisee::sensor::DepthFrame::at()'],['../structagrisee_1_1io_1_1Image.html#ad34f588c721a99ccd3d8239e775e9e9e',1,'agrisee::io::Image::at()']]],
  ['at_5fheight_13',['at_height',['../truss__layout_8hpp.html#a43ac68f9051137d5eabfa85268b1263e',1,'agrisee::study']]],
  ['atomicfile_14',['AtomicFile',['../classagrisee_1_1io_1_1AtomicFile.html#a4fc690e5bf6f78a1f1defc158ca52eda',1,'agrisee::io::AtomicFile']]],
  ['average_5fin_5fvoxels_15',['average_in_voxels',['../voxel_8hpp.html#a523f0118989a4b2b34592f5a01779b36',1,'agrisee']]]
];

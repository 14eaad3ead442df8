var searchData=
[
  ['ids_0',['ids',['../classagrisee_1_1Grid.html#adc0ccaa78c81de61df604f583c105732',1,'agrisee::Grid']]],
  ['indices_5fby_5flabel_1',['indices_by_label',['../poses_8hpp.html#aecb1781e26c58832483fe6434cdcd112',1,'agrisee']]],
  ['insert_2',['insert',['../classagrisee_1_1HashGrid.html#ac3c83000ca2bf38eab4d3256718accd7',1,'agrisee::HashGrid::insert()'],['../classagrisee_1_1see_1_1DensityMap.html#aa97def041fb6bd19c77ef630368e4f11',1,'agrisee::see::DensityMap::insert()']]],
  ['interpenetration_3',['interpenetration',['../truss__layout_8hpp.html#a0a357efb5f4c8a6c8ce3ded28e8d8fd1',1,'agrisee::study']]],
  ['intrinsics_5ffrom_5ffov_4',['intrinsics_from_fov',['../intrinsics_8hpp.html#a1ae735814c53e0a6775c3d07fa4be3c0',1,'agrisee::sensor']]],
  ['intrinsics_5fof_5',['intrinsics_of',['../ros_8hpp.html#a80487820a59d5796b61c8153282ef017',1,'agrisee::interop']]],
  ['inverse_6',['inverse',['../ur3_8hpp.html#a429f5a738959838aabdb169187a931cf',1,'agrisee::arm']]],
  ['is_5ffinite_7',['is_finite',['../cloud_8hpp.html#a1e761a56d1186290c05acfd49b721a75',1,'agrisee']]],
  ['is_5frigid_8',['is_rigid',['../pose_8hpp.html#a2745008f2077835b23b447d7245ee207',1,'agrisee']]],
  ['is_5fvisible_9',['is_visible',['../occlusion_8hpp.html#a1d512446989a2feb71ad3b113681dda3',1,'agrisee::see']]]
];

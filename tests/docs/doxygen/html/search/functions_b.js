var searchData=
[
  ['leaf_5fmesh_0',['leaf_mesh',['../truss__mesh_8hpp.html#a88007ccbfd0eef6132ffd31b759da680',1,'agrisee::study']]],
  ['leaflet_5fmesh_1',['leaflet_mesh',['../truss__parts_8hpp.html#ac00f58f421ee48e89c92c7f088f64ba8',1,'agrisee::study']]],
  ['left_2',['left',['../classagrisee_1_1study_1_1GreedyCover.html#a9a443d8403477f8d69fde67da9feef5f',1,'agrisee::study::GreedyCover']]],
  ['link_5fframes_3',['link_frames',['../ur3_8hpp.html#acd7f61efde6a44e06328100022a65654',1,'agrisee::arm']]],
  ['locate_4',['locate',['../locate_8hpp.html#a5bf0d93e2708a95df6438e9bf4ec0f99',1,'agrisee']]],
  ['look_5falong_5',['look_along',['../pose_8hpp.html#a72a27d70ab9fa9372518db21f7bb9343',1,'agrisee']]],
  ['loss_5fprobability_6',['loss_probability',['../depth__noise_8hpp.html#abfe4eda5cc1245b33458c7663cdd4b3a',1,'agrisee::sensor']]]
];

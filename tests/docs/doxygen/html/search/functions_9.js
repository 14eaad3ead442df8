var searchData=
[
  ['jacobian_0',['jacobian',['../ur3_8hpp.html#ae696a1b53c6780b24aada28ac8a55586',1,'agrisee::arm']]],
  ['join_1',['join',['../classagrisee_1_1DisjointSets.html#a2588cb90fd455a30efc3233a0f2ac1d8',1,'agrisee::DisjointSets']]],
  ['join_5fneighbors_2',['join_neighbors',['../components_8hpp.html#a2ff1e2d4c99d0ead374cc83b98c3798f',1,'agrisee']]],
  ['joint_5fconfigurations_3',['joint_configurations',['../joint__path_8hpp.html#a39b1c487f0eae84bce97d4dfee2400f4',1,'agrisee::study']]],
  ['joint_5fdistance_4',['joint_distance',['../limits_8hpp.html#a29706146c8e0c5095f01171c1fd9f101',1,'agrisee::arm']]],
  ['joint_5fpath_5flength_5',['joint_path_length',['../joint__path_8hpp.html#a8cb81b126e36e2865dbefea8c463eb7b',1,'agrisee::study::joint_path_length(const Joints &amp;start, const std::vector&lt; Joints &gt; &amp;configurations)'],['../joint__path_8hpp.html#ada39b57f5fd42ce5170197ed7e922331',1,'agrisee::study::joint_path_length(const Joints &amp;start, const std::vector&lt; View &gt; &amp;views)']]],
  ['judge_5fscene_6',['judge_scene',['../run__cell_8hpp.html#a9aa063ace5c215be2a479538f9cc0a0c',1,'agrisee::study']]]
];

var searchData=
[
  ['reachable_0',['reachable',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3daa0fefe3b7423f88d38b84c1558ed4880',1,'agrisee']]],
  ['refused_5fmotion_1',['refused_motion',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33adf872a72299a1d7967aef981fbe621ce',1,'agrisee::study']]],
  ['rough_2',['rough',['../structagrisee_1_1sensor_1_1NoiseModel.html#a41630752e5b192922efedee6a66b28a5a0e4f006ac453f392432505cedc762b19',1,'agrisee::sensor::NoiseModel']]]
];

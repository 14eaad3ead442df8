var searchData=
[
  ['kind_0',['Kind',['../structagrisee_1_1sensor_1_1NoiseModel.html#a41630752e5b192922efedee6a66b28a5',1,'agrisee::sensor::NoiseModel']]]
];

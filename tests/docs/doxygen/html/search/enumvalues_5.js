var searchData=
[
  ['gaussian_0',['gaussian',['../structagrisee_1_1sensor_1_1NoiseModel.html#a41630752e5b192922efedee6a66b28a5a304e2a3b544f6b9f267a151e1bcee487',1,'agrisee::sensor::NoiseModel']]]
];

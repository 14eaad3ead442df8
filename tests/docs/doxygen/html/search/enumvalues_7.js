var searchData=
[
  ['l515_0',['l515',['../structagrisee_1_1sensor_1_1NoiseModel.html#a41630752e5b192922efedee6a66b28a5ad992390a21424078d1f7630ae2a06cd5',1,'agrisee::sensor::NoiseModel']]],
  ['low_5fgain_1',['low_gain',['../result_8hpp.html#a5a36fd570f8a1846bf4f88dd873dbadbabfc4b26b692fe7e93a4a9fc3f7998f36',1,'agrisee']]]
];

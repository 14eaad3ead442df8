var searchData=
[
  ['icpparameters_0',['IcpParameters',['../structagrisee_1_1IcpParameters.html',1,'agrisee']]],
  ['icpresult_1',['IcpResult',['../structagrisee_1_1IcpResult.html',1,'agrisee']]],
  ['image_2',['Image',['../structagrisee_1_1io_1_1Image.html',1,'agrisee::io']]],
  ['inputerror_3',['InputError',['../structagrisee_1_1InputError.html',1,'agrisee']]],
  ['intrinsics_4',['Intrinsics',['../structagrisee_1_1sensor_1_1Intrinsics.html',1,'agrisee::sensor']]]
];

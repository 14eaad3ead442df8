var searchData=
[
  ['neighbor_0',['Neighbor',['../structagrisee_1_1Neighbor.html',1,'agrisee']]],
  ['neighborhood_1',['Neighborhood',['../structagrisee_1_1Neighborhood.html',1,'agrisee']]],
  ['neighborlists_2',['NeighborLists',['../structagrisee_1_1NeighborLists.html',1,'agrisee']]],
  ['noisemodel_3',['NoiseModel',['../structagrisee_1_1sensor_1_1NoiseModel.html',1,'agrisee::sensor']]],
  ['noiseparameters_4',['NoiseParameters',['../structagrisee_1_1sensor_1_1NoiseParameters.html',1,'agrisee::sensor']]],
  ['normalparameters_5',['NormalParameters',['../structagrisee_1_1NormalParameters.html',1,'agrisee']]]
];

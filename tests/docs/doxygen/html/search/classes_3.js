var searchData=
[
  ['dbscanparameters_0',['DbscanParameters',['../structagrisee_1_1DbscanParameters.html',1,'agrisee']]],
  ['densitymap_1',['DensityMap',['../classagrisee_1_1see_1_1DensityMap.html',1,'agrisee::see']]],
  ['densitymap_3c_20float_20_3e_2',['DensityMap&lt; float &gt;',['../classagrisee_1_1see_1_1DensityMap.html',1,'agrisee::see']]],
  ['depthframe_3',['DepthFrame',['../structagrisee_1_1sensor_1_1DepthFrame.html',1,'agrisee::sensor']]],
  ['directionbins_4',['DirectionBins',['../structagrisee_1_1DirectionBins.html',1,'agrisee']]],
  ['disjointsets_5',['DisjointSets',['../classagrisee_1_1DisjointSets.html',1,'agrisee']]]
];

var searchData=
[
  ['massparameters_0',['MassParameters',['../structagrisee_1_1MassParameters.html',1,'agrisee']]],
  ['measuredvolumeparameters_1',['MeasuredVolumeParameters',['../structagrisee_1_1MeasuredVolumeParameters.html',1,'agrisee']]],
  ['mesh_2',['Mesh',['../structagrisee_1_1Mesh.html',1,'agrisee']]],
  ['meshmoments_3',['MeshMoments',['../structagrisee_1_1study_1_1MeshMoments.html',1,'agrisee::study']]],
  ['metricparameters_4',['MetricParameters',['../structagrisee_1_1study_1_1MetricParameters.html',1,'agrisee::study']]],
  ['metrics_5',['Metrics',['../structagrisee_1_1study_1_1Metrics.html',1,'agrisee::study']]],
  ['moments_6',['Moments',['../classagrisee_1_1Moments.html',1,'agrisee']]],
  ['mount_7',['Mount',['../structagrisee_1_1arm_1_1Mount.html',1,'agrisee::arm']]]
];

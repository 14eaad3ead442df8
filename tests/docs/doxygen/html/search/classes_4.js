var searchData=
[
  ['ellipsoid_0',['Ellipsoid',['../structagrisee_1_1Ellipsoid.html',1,'agrisee']]],
  ['ellipsoidfit_1',['EllipsoidFit',['../structagrisee_1_1EllipsoidFit.html',1,'agrisee']]],
  ['error_2',['Error',['../structagrisee_1_1Error.html',1,'agrisee']]],
  ['errorsummary_3',['ErrorSummary',['../structagrisee_1_1study_1_1ErrorSummary.html',1,'agrisee::study']]],
  ['estimate_4',['Estimate',['../structagrisee_1_1Estimate.html',1,'agrisee']]],
  ['evidence_5',['Evidence',['../structagrisee_1_1plan_1_1Evidence.html',1,'agrisee::plan']]],
  ['expectedsurface_6',['ExpectedSurface',['../classagrisee_1_1plan_1_1ExpectedSurface.html',1,'agrisee::plan']]],
  ['expectedsurfaceparameters_7',['ExpectedSurfaceParameters',['../structagrisee_1_1plan_1_1ExpectedSurfaceParameters.html',1,'agrisee::plan']]]
];

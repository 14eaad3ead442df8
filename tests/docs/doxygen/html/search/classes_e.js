var searchData=
[
  ['object_0',['Object',['../structagrisee_1_1Object.html',1,'agrisee']]],
  ['observability_1',['Observability',['../structagrisee_1_1study_1_1Observability.html',1,'agrisee::study']]],
  ['orientationparameters_2',['OrientationParameters',['../structagrisee_1_1OrientationParameters.html',1,'agrisee']]],
  ['orientedcylinder_3',['OrientedCylinder',['../structagrisee_1_1OrientedCylinder.html',1,'agrisee']]],
  ['orientedellipsoid_4',['OrientedEllipsoid',['../structagrisee_1_1OrientedEllipsoid.html',1,'agrisee']]]
];

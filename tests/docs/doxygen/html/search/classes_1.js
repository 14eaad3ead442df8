var searchData=
[
  ['baseplace_0',['BasePlace',['../structagrisee_1_1study_1_1BasePlace.html',1,'agrisee::study']]],
  ['basesearchparameters_1',['BaseSearchParameters',['../structagrisee_1_1study_1_1BaseSearchParameters.html',1,'agrisee::study']]],
  ['body_2',['Body',['../structagrisee_1_1Body.html',1,'agrisee']]],
  ['bodycandidate_3',['BodyCandidate',['../structagrisee_1_1BodyCandidate.html',1,'agrisee']]],
  ['bodyparameters_4',['BodyParameters',['../structagrisee_1_1BodyParameters.html',1,'agrisee']]],
  ['box_5',['Box',['../structagrisee_1_1Box.html',1,'agrisee']]],
  ['bvh_6',['Bvh',['../classagrisee_1_1Bvh.html',1,'agrisee']]],
  ['bytes_7',['Bytes',['../structagrisee_1_1io_1_1Bytes.html',1,'agrisee::io']]]
];

var searchData=
[
  ['l515_0',['L515',['../structagrisee_1_1sensor_1_1L515.html',1,'agrisee::sensor']]],
  ['limitparameters_1',['LimitParameters',['../structagrisee_1_1study_1_1LimitParameters.html',1,'agrisee::study']]],
  ['locatedfruit_2',['LocatedFruit',['../structagrisee_1_1study_1_1LocatedFruit.html',1,'agrisee::study']]]
];

var searchData=
[
  ['hashgrid_0',['HashGrid',['../classagrisee_1_1HashGrid.html',1,'agrisee']]],
  ['hashgrid_3c_20float_20_3e_1',['HashGrid&lt; float &gt;',['../classagrisee_1_1HashGrid.html',1,'agrisee']]],
  ['hit_2',['Hit',['../structagrisee_1_1Bvh_1_1Hit.html',1,'agrisee::Bvh']]]
];

var searchData=
[
  ['z_0',['z',['../structagrisee_1_1Neighborhood.html#af0e55349ea4cc87dabca5f1d8e68de71',1,'agrisee::Neighborhood::z()'],['../structagrisee_1_1Tile.html#adfdaf2abee26321f4d038177d8591622',1,'agrisee::Tile::z()']]]
];

var searchData=
[
  ['y_0',['y',['../structagrisee_1_1Neighborhood.html#a93e1b1678d771b57f4dd5a1a13002f36',1,'agrisee::Neighborhood::y()'],['../structagrisee_1_1Tile.html#a8e1ebc038a20de8c980607e819c05872',1,'agrisee::Tile::y()']]]
];

var searchData=
[
  ['x_0',['x',['../structagrisee_1_1Neighborhood.html#ab98ba306e6a0f2751117216b83a5dbf8',1,'agrisee::Neighborhood::x()'],['../structagrisee_1_1Tile.html#a45ef8e939831469709b6013ea6cc8582',1,'agrisee::Tile::x()']]]
];

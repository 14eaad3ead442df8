var searchData=
[
  ['tile_0',['Tile',['../structagrisee_1_1Tile.html',1,'agrisee']]],
  ['timing_1',['Timing',['../structagrisee_1_1Timing.html',1,'agrisee']]],
  ['tracedscene_2',['TracedScene',['../classagrisee_1_1TracedScene.html',1,'agrisee']]],
  ['trianglehit_3',['TriangleHit',['../structagrisee_1_1TriangleHit.html',1,'agrisee']]],
  ['truefruit_4',['TrueFruit',['../structagrisee_1_1study_1_1TrueFruit.html',1,'agrisee::study']]],
  ['truss_5',['Truss',['../structagrisee_1_1study_1_1Truss.html',1,'agrisee::study']]],
  ['trusslayout_6',['TrussLayout',['../structagrisee_1_1study_1_1TrussLayout.html',1,'agrisee::study']]],
  ['trussparameters_7',['TrussParameters',['../structagrisee_1_1study_1_1TrussParameters.html',1,'agrisee::study']]],
  ['truth_8',['Truth',['../structagrisee_1_1study_1_1Truth.html',1,'agrisee::study']]]
];

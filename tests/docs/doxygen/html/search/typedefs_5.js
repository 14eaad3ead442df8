var searchData=
[
  ['labels_0',['Labels',['../types_8hpp.html#ac0d1cdd7ed7fa50086b111a3b7950b8b',1,'agrisee']]],
  ['linkframes_1',['LinkFrames',['../ur3_8hpp.html#a825eb23bd7e442be3ff4109a1e72b9c1',1,'agrisee::arm']]],
  ['look_2',['Look',['../simulated__scan_8hpp.html#ab11b6e9c98d1bb510246edced3c1d93f',1,'agrisee::study']]]
];

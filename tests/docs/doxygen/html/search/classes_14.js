var searchData=
[
  ['workcell_0',['Workcell',['../structagrisee_1_1Workcell.html',1,'agrisee']]]
];

var searchData=
[
  ['neighbors_0',['Neighbors',['../neighbors_8hpp.html#ad5477a0b56e3c4a826832a04ed1bb708',1,'agrisee']]]
];

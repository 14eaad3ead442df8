var searchData=
[
  ['joints_0',['Joints',['../types_8hpp.html#a65b5549283a51e372f01900586c971ea',1,'agrisee']]]
];

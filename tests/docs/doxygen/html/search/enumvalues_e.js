var searchData=
[
  ['unknown_0',['unknown',['../free__space_8hpp.html#a7020aa455ff10ca0ea93b03c2fed2ea8aad921d60486366258809553a3db49a4a',1,'agrisee::plan']]]
];

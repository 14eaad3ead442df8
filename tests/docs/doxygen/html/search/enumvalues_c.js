var searchData=
[
  ['surface_0',['surface',['../free__space_8hpp.html#a7020aa455ff10ca0ea93b03c2fed2ea8ad302e976c9dd527a9521a88c012437c5',1,'agrisee::plan']]]
];

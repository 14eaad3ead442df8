var searchData=
[
  ['fault_0',['Fault',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33',1,'agrisee::study']]]
];

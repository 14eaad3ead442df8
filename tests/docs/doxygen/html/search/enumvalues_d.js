var searchData=
[
  ['through_0',['through',['../free__space_8hpp.html#a7020aa455ff10ca0ea93b03c2fed2ea8aca23ba209cc33678530392b7197fda4d',1,'agrisee::plan']]],
  ['timeout_1',['timeout',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33a90272dda245ae1fb3cf197e91a8689dc',1,'agrisee::study']]]
];

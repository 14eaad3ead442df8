var searchData=
[
  ['durability_0',['Durability',['../files_8hpp.html#a8d23f3926520b3e981da84241a802c10',1,'agrisee::io']]]
];

var searchData=
[
  ['out_5fof_5freach_0',['out_of_reach',['../result_8hpp.html#abd5e0011c94b0ef31b17d4580c47ee3dacbe9d72e5d4b7df361a1ff7edaeee87a',1,'agrisee']]]
];

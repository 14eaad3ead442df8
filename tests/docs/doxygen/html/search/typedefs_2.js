var searchData=
[
  ['faultcounts_0',['FaultCounts',['../faults_8hpp.html#af53c5b439769e914f97fe54558820a05',1,'agrisee::study']]],
  ['flags_1',['Flags',['../visibility_8hpp.html#a8b18391dc7ba73e598dd35ce15daee78',1,'agrisee::study']]]
];

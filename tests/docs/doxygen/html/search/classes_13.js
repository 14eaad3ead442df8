var searchData=
[
  ['view_0',['View',['../structagrisee_1_1View.html',1,'agrisee']]],
  ['viewproposal_1',['ViewProposal',['../structagrisee_1_1see_1_1ViewProposal.html',1,'agrisee::see']]],
  ['viewrecord_2',['ViewRecord',['../structagrisee_1_1io_1_1ViewRecord.html',1,'agrisee::io']]],
  ['viewrequest_3',['ViewRequest',['../structagrisee_1_1plan_1_1ViewRequest.html',1,'agrisee::plan']]],
  ['visibilitygraph_4',['VisibilityGraph',['../structagrisee_1_1see_1_1VisibilityGraph.html',1,'agrisee::see']]],
  ['votedcenter_5',['VotedCenter',['../structagrisee_1_1VotedCenter.html',1,'agrisee']]]
];
